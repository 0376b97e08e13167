"""Runs jobs: a supervisor per slot in the worker process, the pipeline in a child of its own."""
