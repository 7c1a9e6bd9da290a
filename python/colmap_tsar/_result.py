# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the results of all runs have in common."""
import dataclasses
from typing import Any, Dict


@dataclasses.dataclass(frozen=True)
class Result:
    """What a run did or found."""

    def todict(self) -> Dict[str, Any]:
        return dataclasses.asdict(self)


class PrintedResult(Result):
    """One that the command prints. Its last field is that text, which str() gives."""

    text: str

    def __str__(self) -> str:
        return self.text
