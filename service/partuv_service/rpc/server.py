"""The gRPC server: starts and stops with the gateway, on the same event loop."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import grpc
from grpc_health.v1 import health, health_pb2, health_pb2_grpc
from grpc_reflection.v1alpha import reflection
from partuv_contract.pb import unwrap_pb2

from partuv_service.deps import State
from partuv_service.rpc.servicer import Servicer
from partuv_service.rpc.unwrap_pb2_grpc import add_UnwrapServicer_to_server

SERVICE = unwrap_pb2.DESCRIPTOR.services_by_name["Unwrap"].full_name
_MESSAGE_BYTES = 2**20
_GRACE_S = 3.0


@asynccontextmanager
async def serving(state: State) -> AsyncIterator[int]:
    """Serve gRPC meanwhile; gives the port."""
    server = grpc.aio.server(
        options=[
            ("grpc.max_receive_message_length", _MESSAGE_BYTES),
            ("grpc.max_send_message_length", _MESSAGE_BYTES),
            ("grpc.so_reuseport", 0),  # a second gateway on this port is a mistake, not a helper
        ]
    )
    add_UnwrapServicer_to_server(Servicer(state), server)  # type: ignore[no-untyped-call]
    probe = health.aio.HealthServicer()
    health_pb2_grpc.add_HealthServicer_to_server(probe, server)
    reflection.enable_server_reflection(
        (SERVICE, health.SERVICE_NAME, reflection.SERVICE_NAME), server
    )
    host = f"[{state.settings.host}]" if ":" in state.settings.host else state.settings.host
    port = server.add_insecure_port(f"{host}:{state.settings.grpc_port}")
    await server.start()
    for name in ("", SERVICE):
        await probe.set(name, health_pb2.HealthCheckResponse.SERVING)
    try:
        yield port
    finally:
        await probe.enter_graceful_shutdown()
        await server.stop(_GRACE_S)
