"""A panel of widgets that nobody sees: a test sets and clicks them by their labels, and reads what they show."""

from types import SimpleNamespace

from app.page.feature import VisiblePageState


class Widget(SimpleNamespace):
    """It remembers what a click calls, and may hold others."""

    def on_click(self, act):
        self.click = lambda: act(None)

    on_update = on_click

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None


class Gui:
    """Makes widgets of all kinds."""

    def __init__(self):
        self.by_label, self.made = {}, []

    @property
    def said(self):
        return " ".join(widget.content for widget in self.made)

    def add_html(self, content, **_):
        return self._add("", content=content)

    def add_uplot(self, data, series, **options):
        return self._add("", data=data, series=series, **options)

    def add_dropdown(self, label, options, initial_value=None, **_):
        return self._add(label, options=options, value=initial_value or options[0])

    def __getattr__(self, kind):
        return lambda label, value="", *_, **__: self._add(label, value=value)

    def _add(self, label, **what):
        self.made.append(widget := Widget(**{"content": "", "visible": True} | what))
        self.by_label[label] = widget
        return widget


def page_view(alone=True):
    """What a feature sees at a refresh of which it needs nothing but whether the run has the page for itself."""
    return VisiblePageState(None, None, not alone, alone)
