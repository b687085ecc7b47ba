"""Peers behind the Port seam: one file a port, none imports another."""
