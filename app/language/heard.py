"""What solvers have said in a sentence, in the visitor's language."""


def heard(sentence: str) -> str:
    """The sentence in the language that is spoken."""
    return sentence
