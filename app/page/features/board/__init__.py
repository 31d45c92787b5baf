"""The board of a class: how many have said what, without names, and the steps of a lesson opened for all."""
