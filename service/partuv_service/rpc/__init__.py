"""The gRPC interface: the same desk as the REST interface, another language."""
