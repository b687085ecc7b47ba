"""Real senders as judges of ``fraese serve``."""
