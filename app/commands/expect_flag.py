"""Claims of ``--expect`` about a report, in the language of the lessons' claims."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from app.commands.lenient_flag_types import BadInput
from app.commands.output import print_message
from app.lessons.claims import ClaimError, ClaimNamespace, RunOutcome, Vocabulary, check_claim, decide_claim
from solvers.untrusted.quoting import quote


@dataclass(frozen=True)
class ClaimChecker:
    """Checks claims about a report by its paths (``vocabulary``); they may omit the report's ``name``."""

    name: str
    vocabulary: Vocabulary

    def validate_claims(self, claims: Sequence[str]) -> None:
        """Raises :class:`BadInput` for a claim that no report can decide; "error.x.max < 1e-3" is one it can."""
        for claim in claims:
            try:
                check_claim(claim, {self.name: None}, self.name, self.vocabulary)
            except ClaimError as error:
                raise BadInput("expect", claim, str(error)) from None

    def report_claims(self, claims: Sequence[str], outcomes: list[Mapping[str, Any]], over: str = "",
                      words: Mapping[str, str] = MappingProxyType({})) -> int:
        """Prints whether claims hold for reports, which differ in ``over``; returns the exit status, 1 if one fails.
        ``words`` says of paths why they have no value, or what makes it doubtful."""
        missed = 0
        scope = ClaimNamespace({self.name: RunOutcome(outcomes, over)}, self.name, self.vocabulary)
        for claim in claims:
            said = [f"{path}: {why}" for path, why in words.items() if path in claim]
            try:
                decided = decide_claim(claim, scope)
                holds, found = decided.holds, ", ".join(dict.fromkeys(decided.text.split(", ")))  # order: of all grids
            except ClaimError as error:  # one without a value does not hold
                holds, found = False, "" if said else str(error)
            found = "; ".join(filter(None, [found, *said]))
            print_message(f"expected {quote(claim)}: {'holds' if holds else 'DOES NOT HOLD'} ({found})")
            missed |= not holds
        return int(missed)
