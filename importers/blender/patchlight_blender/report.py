"""Errors and warnings of an export."""
import sys

PREFIX = "patchlight-export"


class ExportError(Exception):
    """A mistake of the user's that ends the export: one sentence that says what to do, and the exit code."""

    def __init__(self, text, code):
        super().__init__(text)
        self.code = code


class Report:
    """Collects warnings and prints each of them once, as one line, to standard error."""

    def __init__(self, stream=None):
        self.warnings = []
        self.stream = stream or sys.stderr

    def warn(self, text):
        text = " ".join(str(text).split())
        if text not in self.warnings:
            self.warnings.append(text)
            print(f"{PREFIX}: warning: {text}", file=self.stream, flush=True)


def names(items, limit=8):
    """The items' names in single quotes, shortened after `limit` of them."""
    shown = sorted(set(items))
    text = ", ".join(f"'{name}'" for name in shown[:limit])
    return text if len(shown) <= limit else f"{text} and {len(shown) - limit} more"
