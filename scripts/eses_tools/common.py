"""Shared by the tools: paths, command lines, errors, files, and the machine."""

import argparse
import contextlib
import errno
import gzip
import io
import math
import os
import pathlib
import platform
import shutil
import signal
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


class Failed(Exception):
    """A run has failed, or something that it needs is missing."""


# -------------------------------------------------------------------------------- command line


class Parser(argparse.ArgumentParser):
    def error(self, message):
        self.exit(2, f"{self.prog}: {message}\n")  # one line, without the usage


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


def end_with(main):
    """Runs a script's main function. Turns errors into one line and an exit code."""
    try:
        if signal.getsignal(signal.SIGINT) == signal.SIG_DFL:  # see quiet_interrupt
            signal.signal(signal.SIGINT, signal.default_int_handler)
        main()
    except BrokenPipeError:
        sys.exit(1)  # the reader has closed the pipe
    except Failed as error:
        sys.exit(f"{NAME}: {error}")
    except OSError as error:
        sys.exit(f"{NAME}: {error.filename or 'output'}: {error.strerror}")
    except KeyboardInterrupt:
        sys.exit(130)


def show(text):
    """Shows the progress on a line that the next one replaces, if standard error is a terminal."""
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)


def printable(text):
    """Returns the text on one line; characters that cannot be printed become question marks."""
    text = str(text).encode("utf-8", "backslashreplace").decode()
    return "".join(c if c.isprintable() else "?" for c in text)


# --------------------------------------------------------------------------------------- files


@contextlib.contextmanager
def text_file(name, compressed=False, **how):
    """Opens a text file for writing, gzipped if `compressed`. Equal text gives equal bytes.

    `name` may be a descriptor, which stays open. `how` is passed to open().
    """
    owned = not isinstance(name, int)
    if not compressed:
        with open(name, "w", closefd=owned, **how) as target:
            yield target
        return
    with (open(name, "wb", closefd=owned) as packed,
          gzip.GzipFile("", "wb", COMPRESSION_LEVEL, packed, mtime=0) as stream,
          io.TextIOWrapper(stream, **how) as target):
        yield target


@contextlib.contextmanager
def complete_file(name, **how):
    """Opens a text file that gets its name when it is complete; `-` is standard output.

    Devices and pipes are written directly, because renaming would put a file in their place. `how`
    is passed to text_file().
    """
    if str(name) == "-" or (os.path.exists(name) and not os.path.isfile(name)):
        with text_file(1 if str(name) == "-" else name, **how) as target:
            yield target
        return
    final = pathlib.Path(os.path.realpath(name))  # the target of a symbolic link
    part = final.with_name(f".{final.name}.{os.getpid()}.part")
    with contextlib.ExitStack() as opened:
        try:
            target = opened.enter_context(text_file(part, **how))
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(name)) from None
        try:
            yield target
            opened.close()
            os.replace(part, final)
        except OSError as error:
            error.filename = error.filename or str(name)  # errors of a full disk have no file name
            raise
        finally:
            part.unlink(missing_ok=True)


def require_writable(folder):
    """Creates the folder. Fails now if results could not be written into it later."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise Failed(f"{folder}: {error.strerror}") from None


def require_writable_file(path):
    """Fails now if complete_file() could not write this file later. Its folder must exist."""
    try:
        if os.path.isdir(path):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if os.path.exists(path) and not os.path.isfile(path):
            open(path, "a").close()
        else:
            tempfile.TemporaryFile(dir=os.path.dirname(os.path.realpath(path))).close()
    except OSError as error:
        raise Failed(f"{path}: {error.strerror}") from None


def unpacked(path, directory):
    """Returns a plain file for the program: the file itself, or the unpacked .gz in `directory`.

    Throws Failed if the .gz is truncated or damaged, OSError if files cannot be read or written.
    """
    if path.suffix.lower() != ".gz":
        return path
    plain = directory / path.stem
    try:
        with gzip.open(path, "rb") as source, open(plain, "wb") as target:
            shutil.copyfileobj(source, target)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise Failed(f"{path}: {error}") from None
    return plain


# ------------------------------------------------------------------------- machine and program


def machine():
    model = platform.machine()
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                model = line.partition(":")[2].strip()
                break
    except OSError:
        pass
    return {"cpu": model, "cores": len(os.sched_getaffinity(0)), "system": platform.system()}


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
