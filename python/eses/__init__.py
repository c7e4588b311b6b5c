"""The old name of the package eses_blocks. The next version will not have it any more."""

import sys
import warnings

from eses_blocks import *  # noqa: F403  # pylint: disable=wildcard-import,unused-wildcard-import
from eses_blocks import __all__, __doc__, __version__, _core  # noqa: F401

warnings.warn("the package eses is now eses_blocks: write `import eses_blocks as eses`", FutureWarning,
              stacklevel=2)
sys.modules[f"{__name__}._core"] = _core  # for programs that name it
