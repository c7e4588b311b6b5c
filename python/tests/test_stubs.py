"""Checks that type stubs and docstrings describe every name of the module."""

import ast
import inspect
import pathlib
import re
import subprocess
import sys

import pytest

import eses_blocks as eses
from eses_blocks import _core

STUB = pathlib.Path(eses.__file__).with_name("_core.pyi")
# Names that Python or pybind11 give to every class, and those that pickle uses.
INHERITED = set(dir(object)) | {"__module__", "__getstate__", "__setstate__", "__slotnames__",
                                "__dict__", "__weakref__", "_pybind11_conduit_v1_"}
OWN = {"__init__", "__eq__", "__hash__"}


def parameters(arguments):
    """Returns the names and defaults of a stub's parameters, and the position where keywords
    begin."""
    plain = arguments.posonlyargs + arguments.args
    defaults = [inspect.Parameter.empty] * (len(plain) - len(arguments.defaults)) + [
        ast.literal_eval(default) for default in arguments.defaults]
    keywords = [inspect.Parameter.empty if default is None else ast.literal_eval(default)
                for default in arguments.kw_defaults]
    return ([(each.arg, default, False) for each, default in zip(plain, defaults)] +
            [(each.arg, default, True) for each, default in zip(arguments.kwonlyargs, keywords)] +
            [(each.arg, inspect.Parameter.empty, False) for each in (arguments.kwarg,) if each])


def actual_parameters(function):
    return [(each.name, each.default, each.kind == each.KEYWORD_ONLY)
            for each in inspect.signature(function).parameters.values()]


def is_property(node):
    return any(isinstance(each, ast.Name) and each.id == "property" for each in node.decorator_list)


def stub_nodes():
    return [node for node in ast.parse(STUB.read_text(encoding="utf-8")).body
            if not getattr(node, "name", "").startswith("_")]


def stub_classes():
    return {node.name: node for node in stub_nodes() if isinstance(node, ast.ClassDef)}


def test_stubs_have_the_names_of_the_module():
    stub = set(stub_classes()) | {node.name for node in stub_nodes()
                                  if isinstance(node, ast.FunctionDef)} | {"__version__"}
    module = {name for name in vars(_core) if not name.startswith("_")} | {"__version__"}
    assert stub == module < set(eses.__all__)
    for name in module:
        assert getattr(eses, name) is getattr(_core, name)


@pytest.mark.parametrize("name", sorted(stub_classes()))
def test_stubs_have_the_members_of_classes(name):
    members = {node.name: node for node in stub_classes()[name].body}
    actual = getattr(_core, name)
    found = {member for member in vars(actual) if member not in INHERITED}
    assert {member for member in members if member not in OWN} == found
    assert inspect.getdoc(actual)
    for member, node in members.items():
        value = inspect.getattr_static(actual, member)
        if is_property(node):
            assert isinstance(value, property), member
            assert value.__doc__ and value.fset is None, member
        elif not member.startswith("__"):
            assert parameters(node.args) == actual_parameters(getattr(actual, member)), member
            assert "Returns\n-------" in value.__doc__ or member == "close", member


@pytest.mark.parametrize("name", ["Grid", "Surface"])
def test_stubs_have_the_parameters_of_constructors(name):
    init = next(node for node in stub_classes()[name].body if node.name == "__init__")
    assert parameters(init.args)[1:] == actual_parameters(getattr(_core, name))
    for parameter, _, _ in parameters(init.args)[1:]:
        assert (f"\n{parameter} : " if parameter != "options" else "\n**options\n") in inspect.getdoc(getattr(_core, name))


def test_stubs_have_the_parameters_of_functions():
    # The last overload of a function is the general one.
    functions = {node.name: node for node in stub_nodes() if isinstance(node, ast.FunctionDef)}
    assert set(functions) == {"measure_frames", "read_atoms", "read_grid"}
    for node in functions.values():
        function = getattr(_core, node.name)
        assert parameters(node.args) == actual_parameters(function)
        for heading in ("Parameters\n----------", "Returns\n-------", "Raises\n------"):
            assert heading in function.__doc__


def test_docstrings_name_every_parameter():
    for function in (eses.Surface.grid, eses.Surface.compute, eses.Surface.blocks, eses.Surface.measure,
                     eses.Grid.coordinates, eses.measure_frames, eses.read_atoms, eses.read_grid,
                     eses.measure, eses.read_molecule, eses.Measurement.save):
        for name in inspect.signature(function).parameters:
            # One line may name several parameters.
            line = rf"(?m)^(\w+, )*{name}(, \w+)* : " if name != "options" else r"(?m)^\*\*options$"
            assert name == "self" or re.search(line, inspect.getdoc(function)), name


def test_package_is_typed():
    assert STUB.with_name("py.typed").is_file()
    for name in eses.__all__:
        if name not in ("__version__", "adaptors"):
            assert getattr(eses, name).__module__ in ("eses_blocks", "eses_blocks._core")


def test_old_name_warns_and_is_the_same_package():
    code = ("import pickle, warnings, eses_blocks\n"
            "with warnings.catch_warnings(record=True) as caught:\n"
            "    import eses, eses._core\n"
            "assert [one.category for one in caught] == [FutureWarning], caught\n"
            "assert 'import eses_blocks as eses' in str(caught[0].message)\n"
            "assert all(getattr(eses, name) is getattr(eses_blocks, name) for name in eses_blocks.__all__)\n"
            "assert eses._core is eses_blocks._core\n"
            # The global `eses Grid`, as in files that earlier versions have pickled.
            "assert pickle.loads(b'ceses\\nGrid\\n.') is eses_blocks.Grid\n")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_module_is_the_program(program):
    done, direct = (subprocess.run([*command, "--version"], capture_output=True, text=True, check=True).stdout
                    for command in ([sys.executable, "-m", "eses_blocks"], [program]))
    assert done == direct


def test_module_shows_one_symbol():
    options = ["-g", "-U"] if sys.platform == "darwin" else ["--dynamic", "--defined-only"]
    done = subprocess.run(["nm", *options, _core.__file__], capture_output=True, text=True, check=True)
    symbols = {line.split()[-1].removeprefix("_") for line in done.stdout.splitlines()}
    assert "PyInit__core" in symbols
    assert not {symbol for symbol in symbols if "eses" in symbol}
