"""Examples in docstrings do what they say."""

import doctest

import numpy as np

import cellfan
from cellfan import _cellfan, _mesh, _session


def test_examples_of_docstrings():
    tried = 0
    for module in (cellfan, _mesh, _session, _cellfan):
        for test in doctest.DocTestFinder(recurse=True).find(
            module, globs={**vars(cellfan), "cellfan": cellfan, "np": np}
        ):
            if test.examples:
                result = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test)
                assert result.failed == 0, test.name
                tried += result.attempted
    assert tried > 15


def test_everything_says_what_it_is():
    for name in cellfan.__all__:
        thing = getattr(cellfan, name)
        assert name == "__version__" or thing.__doc__, name
        for member in vars(thing) if isinstance(thing, type) else ():
            if not member.startswith("_"):
                assert getattr(thing, member).__doc__ is not None or not callable(getattr(thing, member)), (
                    f"{name}.{member}"
                )
