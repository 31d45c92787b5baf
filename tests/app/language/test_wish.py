"""Which language a browser gets: its address goes before its own wish, and what is no language is none."""

import pytest

from app.language.spoken import as_cookie, of_cookie, wished


@pytest.mark.parametrize(("query", "accepted", "found"), [
    ("", "", "en"), ("", "de", "de"), ("", "de-CH,de;q=0.9,en;q=0.8", "de"), ("", "fr, en;q=0.5, de;q=0.4", "en"),
    ("", "en;q=0.4,de;q=0.5", "de"), ("", "de;q=0, en", "en"), ("", "fr,nl", "en"), ("", "de;q=x, en", "en"),
    ("lang=de", "en", "de"), ("lang=en", "de", "en"), ("lang=DE&x=1", "", "de"), ("lang=klingon", "de", "de"),
    ("lang=fr&lang=de", "", "de"), ("lang=", "", "en"), ("&&=%ff;lang", ";q=1,,;;q=", "en"),
    ("x" * 10_000 + "&lang=de", "y," * 10_000, "en")])
def test_the_address_goes_first_then_what_the_browser_likes_best(query, accepted, found):
    assert wished(query, accepted) == found


def test_a_cookie_tells_the_websocket_and_one_of_nobodys_tells_nothing():
    assert of_cookie([f"mpm-lab-8080=x; {as_cookie('de').partition(';')[0]}"]) == "de"
    assert of_cookie([]) == of_cookie(["mpm-lab-language=klingon"]) == of_cookie(["mpm-lab-language"]) == "en"
