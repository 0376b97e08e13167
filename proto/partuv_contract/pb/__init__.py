"""The gRPC messages, generated from proto/partuv/v1/unwrap.proto by proto/generate.py."""
