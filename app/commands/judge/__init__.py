"""Problems for other codes, and the judgement of their particles."""
