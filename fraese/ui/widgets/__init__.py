"""What screens are composed of. A widget shows; what is done, its screen does."""
