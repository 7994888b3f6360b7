"""Errors and messages as tests look at them: by code and parameters, never by their English text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from geofit.data.errors import GeofitError
from geofit.data.messages import Message


@contextmanager
def refused(kind: type[GeofitError], code: str, **params: Any) -> Iterator[pytest.ExceptionInfo[GeofitError]]:
    """Expect an error of a kind with a code and these parameters, among others."""
    with pytest.raises(kind) as caught:
        yield caught
    error = caught.value
    assert error.code == code, str(error)
    reason = getattr(error, "reason", error.message)
    assert {name: reason.params[name] for name in params} == params


def with_code(messages: Iterable[Message], code: str) -> Message:
    """Return the one message of a code."""
    (found,) = [one for one in messages if one.code == code]
    return found
