"""The module that makes pages has no types for callers."""

from typing import Any

def __getattr__(name: str) -> Any: ...
