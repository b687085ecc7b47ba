"""Dialogs and pages above a view: each answers, or shows, one thing."""
