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
    """The signatures that pybind11 writes: in the first line, or numbered."""
    lines = re.findall(r"^[0-9]+\. (.*)$", function.__doc__, re.MULTILINE)
    lines = lines or function.__doc__.split("\n")[:1]
    return [ast.parse(f"def {line}: ...").body[0] for line in lines]


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


def assert_same_signatures(overloads, function):
    actual = from_docstring(function)
    assert [parameters(f) for f in overloads] == [parameters(f) for f in actual]
    assert [returned(f) for f in overloads] == [returned(f) for f in actual]


def test_package_is_typed():
    assert (PACKAGE / "py.typed").exists()


def test_names_are_complete():
    assert sorted([*FUNCTIONS, *CLASSES]) == sorted(rgbd_pose.__all__)
    public = filter(is_public, vars(rgbd_pose))
    assert sorted(public) == sorted(rgbd_pose.__all__)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions(name):
    assert_same_signatures([FUNCTIONS[name]], getattr(rgbd_pose, name))


@pytest.mark.parametrize("class_name, name", METHODS)
def test_methods(class_name, name):
    overloads = [
        node for node in CLASSES[class_name].body
        if isinstance(node, ast.FunctionDef) and node.name == name
    ]
    function = inspect.getattr_static(getattr(rgbd_pose, class_name), name)
    is_static = ["staticmethod"] * isinstance(function, staticmethod)
    for stub in overloads:
        decorators = [ast.unparse(d) for d in stub.decorator_list]
        assert decorators == is_static + ["overload"] * (len(overloads) > 1)
    function = getattr(function, "__func__", function)
    assert_same_signatures(overloads, function)


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
