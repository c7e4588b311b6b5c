"""Types of pages for notebooks."""

import os
from typing import Union

class Page:
    def __init__(self, text: str, height: int) -> None: ...
    def save(self, path: Union[str, os.PathLike[str]]) -> None: ...

def add_methods(atoms: type, mesh: type, result: type, surface: type) -> None: ...
