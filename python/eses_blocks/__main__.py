"""`python -m eses_blocks` is the program eses-blocks."""

from eses_tools import program  # type: ignore

if __name__ == "__main__":
    program.run()
