"""Lets Ctrl-C end a script without a traceback while the script imports its modules.

Scripts import this module before all others. common.end_with() makes it an exception again.
"""

import signal

# A signal that is ignored, as in a background job of a shell, stays ignored.
if signal.getsignal(signal.SIGINT) == signal.default_int_handler:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
