"""What a plane problem with a manufactured solution derives from its displacement: everything but the displacement."""
