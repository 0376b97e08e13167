"""Tells a receiver of the client's choice that a job ended."""
