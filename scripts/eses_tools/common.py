"""Shared by the tools: paths, command lines, errors and files."""

import argparse
import contextlib
import difflib
import errno
import gzip
import importlib
import io
import math
import os
import pathlib
import shutil
import signal
import stat
import subprocess
import sys
import sysconfig
import tempfile
import zlib

FOLDER = pathlib.Path(__file__).resolve().parent  # of the package
PROJECT = FOLDER.parents[1]  # if the package is in a checkout
DATA = PROJECT / "data"
IS_INSTALLED = not (PROJECT / "CMakeLists.txt").is_file()


def default_program():
    """Returns the path of eses-blocks: the one that belongs to this package, or that in PATH."""
    name = "eses-blocks"
    if not IS_INSTALLED:
        return PROJECT / "build" / name
    for folder in (FOLDER.parents[2] / "bin",  # PREFIX/share/eses-blocks/eses_tools, by CMake
                   FOLDER.parents[1],  # BUILD/python/eses_tools, the build tree
                   FOLDER.parent / "bin",  # pip install --target
                   pathlib.Path(sysconfig.get_path("scripts")),
                   pathlib.Path(sysconfig.get_path("scripts", sysconfig.get_preferred_scheme("user")))):
        if os.access(folder / name, os.X_OK) and (folder / name).is_file():
            return folder / name
    return pathlib.Path(shutil.which(name) or name)


def command_of(tool):
    """Returns the beginning of a command that starts another tool of this package."""
    return [sys.executable, FOLDER, tool]


PROGRAM = default_program()
NAME = pathlib.Path(sys.argv[0]).name  # of the tool; installed ones begin with eses-
COMPRESSION_LEVEL = 6  # gzip's own default
RED, YELLOW = 31, 33  # of terminals


class Failed(Exception):
    """A run has failed, or something that it needs is missing."""


# -------------------------------------------------------------------------------- command line


class Parser(argparse.ArgumentParser):
    """Shows the first `lead` paragraphs of `text`, `examples`, pairs of arguments and their meaning, the
    options, and the other paragraphs. --help leaves out the options in `advanced`, which --help-all shows."""

    def __init__(self, text="", lead=1, examples=(), advanced=(), **how):
        paragraphs = text.split("\n\n")
        super().__init__(**{"description": "\n\n".join(paragraphs[:lead]), "epilog": "\n\n".join(paragraphs[lead:]), **how})
        self.examples, self.advanced, self.shows_all = examples, advanced, False
        self.add_argument("--help-all", action=ShowAll, nargs=0,
                          help="show all options and exit" if advanced else argparse.SUPPRESS)

    def add_program(self, what=""):
        """Adds the option --program. `what` says what the program is for."""
        place = "the one beside this script, or build/eses-blocks"
        self.add_argument("--program", type=lambda path: pathlib.Path(path).absolute(), default=PROGRAM.absolute(),
                          metavar="FILE", help=f"path of eses-blocks{what} (default: {place})")

    def parse_known_args(self, args=None, namespace=None):
        """Shows the help, if it is asked for, whatever the other arguments are."""
        words = sys.argv[1:] if args is None else list(args)
        asked = [word for word in words if word in ("-h", "--help", "--help-all")]
        return super().parse_known_args(asked or words, namespace)

    def parse_before_dashes(self):
        """Returns the options, and the arguments after --."""
        arguments = sys.argv[1:]
        at = arguments.index("--") if "--" in arguments else len(arguments)
        return self.parse_args(arguments[:at]), arguments[at + 1:]

    def refuse_own(self, arguments):
        """Ends with exit code 2 if one of the arguments after -- is an option of the tool."""
        own = {name for action in self._actions if action.dest != "help" for name in action.option_strings}
        for name in (each.partition("=")[0] for each in arguments):
            if name in own - {"--help-all"}:
                self.error(f"{name} must come before --")

    def format_help(self):
        hidden = [action for action in self._actions
                  if not self.shows_all and set(action.option_strings) & set(self.advanced)]
        helps = [action.help for action in hidden]
        for action in hidden:
            action.help = argparse.SUPPRESS
        text = super().format_help()
        for action, kept in zip(hidden, helps):
            action.help = kept
        begin, heading, rest = text.partition("\npositional arguments:")
        lines = (f"  {self.prog} {words:{max(len(words) for words, _ in self.examples)}}   {meaning}\n"
                 for words, meaning in self.examples)
        return begin + ("\nexamples:\n" + "".join(lines) if self.examples else "") + heading + rest

    def error(self, message):
        if message.startswith(("unrecognized arguments", "the following arguments are required")):
            message = self.message_of_typo() or message
        if message.startswith("unrecognized arguments") and "-- ARGUMENT" in (self.usage or ""):
            message += "; arguments of eses-blocks follow --"
        self.exit(2, f"{colored(f'{self.prog}:', RED)} {message}\n")  # one line, without the usage

    def message_of_typo(self):
        """Returns the message for the first unknown option that resembles a known one, if there is any."""
        known = [name for action in self._actions for name in action.option_strings if name.startswith("--")]
        words = sys.argv[1:sys.argv.index("--")] if "--" in sys.argv else sys.argv[1:]
        for name in (word.partition("=")[0] for word in words if word.startswith("--")):
            close = difflib.get_close_matches(name, known, 1)
            if close and not any(other.startswith(name) for other in known):
                return f"unknown option {printable(name)}; did you mean {close[0]}?"
        return ""


class ShowAll(argparse.Action):
    """Prints the help with all options."""

    def __call__(self, parser, *_):
        parser.shows_all = True
        parser.print_help()
        parser.exit()


def positive(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("at least 1")
    return value


def at_least(least, is_open=False):
    """Returns a converter for finite numbers of at least `least`, or above it if `is_open`."""
    def convert(text):
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise argparse.ArgumentTypeError("expected a number")
        if value < least or (is_open and value == least):
            raise argparse.ArgumentTypeError(
                f"expected {'more than' if is_open else 'at least'} {least}")
        return value
    return convert


def between(least, largest, kind=float):
    """Returns a converter for numbers from `least` to `largest`."""
    def convert(text):
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not least <= value <= largest:
            raise argparse.ArgumentTypeError(
                f"expected a {'whole ' if kind is int else ''}number from {least:g} to {largest:g}")
        return value
    return convert


def end_on_signal(number, _):
    """Ends the script by an exception, so that temporary files and programs that it has started go with it. The same
    signal is ignored from now on, because a second exception would stop this and print a traceback."""
    signal.signal(number, signal.SIG_IGN)
    if number == signal.SIGINT:
        raise KeyboardInterrupt
    sys.exit(128 + number)


def end_on_signals():
    """Makes Ctrl-C, SIGTERM, SIGHUP and SIGQUIT end the script by `end_on_signal`."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
        # A signal that is ignored stays ignored.
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, end_on_signal)


def imported(name, advice):
    """Returns a module that only this tool needs."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise Failed(f"the Python package {name.partition('.')[0]} is missing ({error}); {advice}") from None


def end_with(main):
    """Runs a script's main function. Turns errors into one line and an exit code."""
    try:
        end_on_signals()
        main()
    except BrokenPipeError:
        sys.exit(1)  # the reader has closed the pipe
    except Failed as error:
        sys.exit(f"{colored(f'{NAME}:', RED)} {printable_lines(error)}")
    except OSError as error:
        sys.exit(f"{colored(f'{NAME}:', RED)} {printable(error.filename or 'output')}: {error.strerror or error}")
    except KeyboardInterrupt:
        sys.exit(130)


# Of texts, pages and pictures.
SUFFIXES = ".txt .md .html .htm .png .jpg .jpeg .gif .svg .tif .tiff .bmp .webp .pdf".split()


def require_kind(parser, path, what, *suffixes):
    """Ends with exit code 2 if the name of an output is that of another kind of file."""
    if path.suffix.lower() in SUFFIXES and path.suffix.lower() not in suffixes:
        parser.error(f"--output: {path} would be {what}, not a {path.suffix} file; use a name that "
                     f"ends in {suffixes[0]}")


def show(text):
    """Shows the progress on a line that the next one replaces, if standard error is a terminal."""
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)


def say(text):
    """Prints a line on standard error, which replaces the line of progress."""
    show("")
    warning = "warning:"
    if text.startswith(warning):
        text = colored(warning, YELLOW) + text[len(warning):]
    print(f"{NAME}: {text}", file=sys.stderr, flush=True)


def colored(text, color):
    """Returns the text in a colour if standard error is a terminal that shows colours, and the user has
    not refused them (https://no-color.org)."""
    terminal = os.environ.get("TERM", "dumb")
    is_shown = terminal != "dumb" and not os.environ.get("NO_COLOR") and sys.stderr.isatty()
    return f"\033[1;{color}m{text}\033[0m" if is_shown else text


def printable(text):
    """Returns the text on one line; characters that cannot be printed become question marks."""
    text = str(text).encode("utf-8", "backslashreplace").decode()
    return "".join(c if c.isprintable() else "?" for c in text)


def counted(count, noun):
    """Returns a count with its noun, such as 1 frame or 2 frames."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def printable_lines(text):
    """Returns printable() of each line."""
    return "\n".join(map(printable, str(text).split("\n")))


# --------------------------------------------------------------------------------------- files


@contextlib.contextmanager
def output_file(name, compressed=False, mode="w", **how):
    """Opens a file for writing, gzipped if `compressed`. Equal text gives equal bytes.

    `name` may be a descriptor, which stays open. `mode` and `how` are passed to open().
    """
    owned = not isinstance(name, int)
    if not compressed:
        with open(name, mode, closefd=owned, **how) as target:
            yield target
        return
    with (open(name, "wb", closefd=owned) as packed,
          gzip.GzipFile("", "wb", COMPRESSION_LEVEL, packed, mtime=0) as stream,
          io.TextIOWrapper(stream, **how) as target):
        yield target


def is_special(path):
    """Whether something other than a regular file exists, such as a device, pipe or folder."""
    return os.path.exists(path) and not os.path.isfile(path)


@contextlib.contextmanager
def named_errors(name):
    """Adds the name of a file to errors without one, such as those of a full disk."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        error.filename = error.filename or str(name)
        raise


def part_of(final):
    """Returns the path of an incomplete file. Names have at most 255 bytes."""
    name = os.fsencode(final.name)[:200].decode("utf-8", "ignore")
    return final.with_name(f".{name}.{os.getpid()}.part")


@contextlib.contextmanager
def complete_file(name, **how):
    """Opens a file that gets its name when it is complete; `-` is standard output.

    Devices and pipes are written directly, because renaming would put a file in their place. `how`
    is passed to output_file().
    """
    if str(name) == "-" or is_special(name):
        with named_errors("output" if str(name) == "-" else name), \
                output_file(1 if str(name) == "-" else name, **how) as target:
            yield target
        return
    final = pathlib.Path(os.path.realpath(name))  # the target of a symbolic link
    part = part_of(final)
    with contextlib.ExitStack() as opened:
        try:
            target = opened.enter_context(output_file(part, **how))
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(name)) from None
        try:
            with named_errors(name):
                yield target
                opened.close()
                os.replace(part, final)
        finally:
            part.unlink(missing_ok=True)


def require_writable(folder):
    """Creates the folder. Fails now if results could not be written into it later."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise Failed(f"{folder}: {error.strerror}") from None


def require_file(path):
    """Fails if there is no regular file of this name."""
    if not path.is_file():
        kind = "a directory, not a file" if path.is_dir() else "not a regular file" if path.exists() else "no such file"
        raise Failed(f"{path}: {kind}")


def input_file(text):
    """Returns the path of an input, for the `type` of arguments: a missing file is reported before missing options
    and packages. `-` is standard input."""
    if text != "-" and not os.path.exists(text):
        raise Failed(f"{text}: no such file")
    return pathlib.Path(text)


def require_output(path, inputs=()):
    """Fails now if complete_file() could not write this file later, or if it is one of the inputs
    under any name. Its folder must exist; `-` is standard output or input."""
    if str(path) != "-":
        require_writable_file(path)
    status = regular_status(path, 1)
    for name in inputs:
        other = regular_status(name, 0)
        if status and other and os.path.samestat(status, other):
            what = "standard output" if str(path) == "-" else path
            which = "an input file" if str(path) == str(name) else f"the input file {name}"
            raise Failed(f"{what} is {which}, and would be overwritten; choose another name")


def file_argument(path):
    """Returns the path of a file as an argument of another program, which no option begins like."""
    text = os.fspath(path)
    return f"./{text}" if text.startswith("-") and text != "-" else text


def files_among(arguments):
    """Returns the files that arguments of eses-blocks name, such as that of --radii."""
    values = (value for argument in map(str, arguments) for value in (argument, argument.partition("=")[2]))
    return [value for value in values if value and os.path.isfile(value)]


def regular_status(path, descriptor):
    """Returns the status of a regular file, or None. Terminals and pipes may be both input and
    output. `-` is the descriptor."""
    try:
        status = os.stat(descriptor if str(path) == "-" else path)
    except OSError:
        return None
    return status if stat.S_ISREG(status.st_mode) else None


def require_writable_file(path):
    try:
        if os.path.isdir(path):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        final = pathlib.Path(os.path.realpath(path))
        if final.is_fifo():
            return  # opening and closing it would be the end of the file for its reader
        if is_special(path):
            open(path, "ab").close()
        else:
            os.lstat(final.parent)  # names the error of a missing folder
            with contextlib.suppress(FileNotFoundError):
                os.lstat(final)  # a name that is too long
            tempfile.TemporaryFile(dir=final.parent).close()
    except OSError as error:
        raise Failed(f"cannot write {path}: {error.strerror}") from None


def unpacked(path, directory):
    """Returns a plain file for the program: the file itself, or the unpacked .gz in `directory`.

    Throws Failed if the .gz is truncated or damaged, OSError if files cannot be read or written.
    """
    if path.suffix.lower() != ".gz":
        return path
    plain = directory / path.stem
    with gzip_errors(path), gzip.open(path, "rb") as source, open(plain, "wb") as target:
        shutil.copyfileobj(source, target)
    return plain


@contextlib.contextmanager
def gzip_errors(path):
    """Throws Failed with the name of a gzipped file that is truncated or damaged."""
    try:
        yield
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise Failed(f"{path}: the file is damaged: {error}") from None


# ------------------------------------------------------------------------------------- program


def describe_build(program):
    """Returns the lines of --version: program and version, then compiler, build type and flags."""
    try:
        done = subprocess.run([program, "--version"], stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, check=True)
    except OSError as error:
        advice = "; install eses-blocks" if IS_INSTALLED else "; build it with scripts/quickstart"
        raise Failed(f"{program}: {error.strerror}{advice}") from None
    except subprocess.CalledProcessError:
        raise Failed(f"{program} --version fails") from None
    if not done.stdout.startswith("eses-blocks "):
        raise Failed(f"{program} is not eses-blocks")
    return done.stdout.splitlines()
