"""What a visitor does on the stage itself: looks at it, marks a particle, reads a region off."""
