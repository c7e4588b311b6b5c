"""Starts the program eses-blocks under its names, for commands that pip installs."""

import os
import sys

from eses_tools.common import PROGRAM


def run(*arguments):
    """Replaces this process by eses-blocks with these arguments and those of the command line."""
    try:
        os.execv(PROGRAM, [str(PROGRAM), *arguments, *sys.argv[1:]])
    except OSError as error:
        sys.exit(f"{PROGRAM}: {error.strerror}; install eses-blocks")


def msms():
    run("msms")


def pdb_to_xyzr():
    run("pdb_to_xyzr")


def pdb_to_xyzrn():
    run("pdb_to_xyzrn")
