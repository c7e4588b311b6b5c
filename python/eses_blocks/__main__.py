"""`python -m eses_blocks` is the program eses-blocks."""

from eses_tools import program

program.run()
