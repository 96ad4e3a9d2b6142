"""What is called in another process comes back, and so does what goes wrong there."""

from __future__ import annotations

import os

import pytest

from pymoo_gridpath.testing import elsewhere as module
from pymoo_gridpath.testing.elsewhere import elsewhere


def speak():
    print("in between")
    os.write(1, b"what is meant for nobody")
    return "said"


def end():
    os._exit(3)


def test_one_other_process_answers_all_calls():
    assert elsewhere(os.getpid) == elsewhere(os.getpid) != os.getpid()
    assert elsewhere(divmod, 7, 2) == (3, 1)


def test_its_hashes_have_a_seed_of_their_own():
    assert elsewhere(hash, "a cell") != hash("a cell")


def test_what_is_printed_there_is_no_answer():
    assert elsewhere(speak) == "said"


def test_what_is_raised_there_is_told():
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        elsewhere(divmod, 1, 0)
    assert elsewhere(divmod, 7, 2) == (3, 1)


def test_what_cannot_be_sent_is_no_request():
    with pytest.raises((AttributeError, TypeError, module.pickle.PicklingError)):
        elsewhere(lambda: 1)
    assert elsewhere(divmod, 7, 2) == (3, 1)


def test_another_begins_where_one_has_ended():
    with pytest.raises(RuntimeError, match="another process ended"):
        elsewhere(end)
    assert elsewhere(divmod, 7, 2) == (3, 1)


def test_it_ends_with_whoever_asks():
    pid = elsewhere(os.getpid)
    process = module._process(tuple(filter(None, module.sys.path)))
    assert process.pid == pid
    process.communicate(timeout=30)
    assert process.returncode == 0
    module._process.cache_clear()
