"""What the gateway does with jobs, whichever interface a request came through."""
