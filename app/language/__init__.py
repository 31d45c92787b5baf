"""Languages: texts of the page and the player are English in the code, and translated by ``de.po`` in this folder."""
