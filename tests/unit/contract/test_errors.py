import inspect

from partuv_contract import errors
from partuv_contract.errors import InputError, MalformedGlbError, PartuvError


def _tree(root):
    """The part of the tree that this module holds; the service's errors continue it elsewhere."""
    children = [child for child in root.__subclasses__() if child.__module__ == errors.__name__]
    return [root, *(leaf for child in children for leaf in _tree(child))]


def test_every_error_has_a_code_of_its_own_and_stands_in_the_tree_of_the_docstring():
    found = _tree(PartuvError)
    assert len({error.code for error in found}) == len(found)
    for error in found:
        assert error.__name__ in errors.__doc__
        if not error.__subclasses__():
            assert f"{error.code}:" in errors.__doc__


def test_all_exceptions_of_the_module_belong_to_the_tree():
    classes = {value for value in vars(errors).values() if inspect.isclass(value)}
    assert {c for c in classes if issubclass(c, Exception)} == set(_tree(PartuvError))


def test_faults_of_the_input_are_client_errors():
    assert all(400 <= error.http_status < 500 for error in _tree(InputError))


def test_as_dict_says_where():
    error = MalformedGlbError("odd", pointer="/nodes/3", byte_offset=12)
    assert error.as_dict() == {
        "code": "malformed_glb",
        "message": "odd",
        "pointer": "/nodes/3",
        "byte_offset": 12,
    }
    assert str(error) == "odd (at /nodes/3, at byte 12)"
    assert PartuvError("x").as_dict() == {"code": "internal", "message": "x"}
