"""Peers behind the Card seam: one file a card, none imports another."""
