"""What is wrong with a file."""

from solvers.outside import quoting


class FileError(ValueError):
    """A file that cannot be read or judged: ``file`` is its name, ``sentence`` says what is wrong and what is
    allowed."""

    def __init__(self, file: str, sentence: str):
        self.file, self.sentence = file, quoting.sentence(sentence)
        super().__init__(quoting.sentence(f"{quoting.quoted(file)}: {sentence}"))
