"""The board of a class: counts of the answers, without names, and the steps of a lesson opened for all."""
