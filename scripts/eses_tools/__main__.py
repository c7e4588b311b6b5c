"""Starts a tool: `python -m eses_tools TOOL [ARGUMENT...]`, or this folder in place of `-m eses_tools`."""

import importlib
import os
import sys

TOOLS = ("apbs", "assemble", "pdbbind", "render", "report", "traj", "view")

if not __package__:  # the folder was started, and is the first place of modules
    sys.dont_write_bytecode = True
    sys.path[0] = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
if sys.argv[1:2] == [] or sys.argv[1] not in TOOLS:
    sys.exit(f"usage: python -m eses_tools {{{','.join(TOOLS)}}} [ARGUMENT...]")
tool = sys.argv.pop(1)
sys.argv[0] = f"eses-{tool}"
importlib.import_module(f"eses_tools.{tool}").start()
