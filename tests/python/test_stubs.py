"""__init__.pyi agrees with the module."""

import ast
import inspect
import pathlib
import re

import pytest

import rgbd_pose

PACKAGE = pathlib.Path(rgbd_pose.__file__).parent
STUB = ast.parse((PACKAGE / "__init__.pyi").read_text())


def is_public(name):
    return not name.startswith("_")


def stubs(body, kind):
    return {node.name: node for node in body if isinstance(node, kind)}


FUNCTIONS = stubs(STUB.body, ast.FunctionDef)
CLASSES = stubs(STUB.body, ast.ClassDef)
METHODS = [
    (class_name, name)
    for class_name, node in CLASSES.items()
    for name, method in stubs(node.body, ast.FunctionDef).items()
    if not any(ast.unparse(d) == "property" for d in method.decorator_list)
]


def from_docstring(function):
    """The signature that pybind11 writes as a docstring's first line."""
    line = function.__doc__.split("\n")[0]
    return ast.parse(f"def {line}: ...").body[0]


def parameters(function):
    """Names with their kinds and defaults, in order."""
    a = function.args
    assert a.vararg is None and a.kwarg is None and not a.posonlyargs
    defaults = [None] * (len(a.args) - len(a.defaults)) + a.defaults
    plain = zip(["plain"] * len(a.args), a.args, defaults)
    keyword = zip(["keyword"] * len(a.kwonlyargs), a.kwonlyargs, a.kw_defaults)
    return [
        (kind, arg.arg, default and repr(ast.literal_eval(default)))
        for kind, arg, default in [*plain, *keyword]
    ]


def returned(function):
    """The class of the module that it returns; None for other types."""
    name = ast.unparse(function.returns).split(".")[-1].strip("'\"")
    return name if name in CLASSES else None


def assert_same_signature(stub, function):
    actual = from_docstring(function)
    assert parameters(stub) == parameters(actual)
    assert returned(stub) == returned(actual)


def test_package_is_typed():
    assert (PACKAGE / "py.typed").exists()


def test_names_are_complete():
    assert sorted([*FUNCTIONS, *CLASSES]) == sorted(rgbd_pose.__all__)
    public = filter(is_public, vars(rgbd_pose))
    assert sorted(public) == sorted(rgbd_pose.__all__)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions(name):
    assert_same_signature(FUNCTIONS[name], getattr(rgbd_pose, name))


@pytest.mark.parametrize("class_name, name", METHODS)
def test_methods(class_name, name):
    stub = stubs(CLASSES[class_name].body, ast.FunctionDef)[name]
    function = inspect.getattr_static(getattr(rgbd_pose, class_name), name)
    is_static = [ast.unparse(d) for d in stub.decorator_list]
    assert is_static == ["staticmethod"] * isinstance(function, staticmethod)
    function = getattr(function, "__func__", function)
    assert_same_signature(stub, function)


@pytest.mark.parametrize("name", CLASSES)
def test_classes(name):
    cls, stub = getattr(rgbd_pose, name), CLASSES[name]
    bases = [ast.unparse(base) for base in stub.bases]
    if bases:
        assert [base.__name__ for base in cls.__bases__] == bases
    if issubclass(cls, Exception):
        return
    members = stubs(stub.body, ast.FunctionDef)
    assert sorted(filter(is_public, vars(cls))) == sorted(
        filter(is_public, members)
    )
    for member, node in members.items():
        if [ast.unparse(d) for d in node.decorator_list] == ["property"]:
            assert isinstance(vars(cls)[member], property), member


@pytest.mark.parametrize("name", rgbd_pose.__all__)
def test_everything_is_documented(name):
    thing = getattr(rgbd_pose, name)
    assert thing.__doc__.strip()
    assert not re.search(r"--[a-z]", thing.__doc__), "flags of programs"
    for member, value in vars(thing).items() if isinstance(thing, type) else ():
        if is_public(member):
            assert inspect.getdoc(value), member
