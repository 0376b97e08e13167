"""What routes ask for: the desk, and who is calling."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, cast

from fastapi import Depends, Header, Request
from partuv_store import AsyncStore

from partuv_service.callers import ApiKeys, Caller
from partuv_service.jobs.desk import Desk
from partuv_service.metrics import Metrics
from partuv_service.settings import Settings


@dataclass(frozen=True)
class State:
    """What lives as long as the gateway."""

    settings: Settings
    store: AsyncStore
    desk: Desk
    keys: ApiKeys
    metrics: Metrics


def state_of(request: Request) -> State:
    """The gateway's state."""
    return cast(State, request.app.state.partuv)


StateDep = Annotated[State, Depends(state_of)]


def desk_of(state: StateDep) -> Desk:
    """Where jobs are ordered and looked after."""
    return state.desk


DeskDep = Annotated[Desk, Depends(desk_of)]


async def caller_of(
    state: StateDep,
    authorization: Annotated[str | None, Header(include_in_schema=False)] = None,
    x_api_key: Annotated[str | None, Header(include_in_schema=False)] = None,
) -> Caller:
    """Who calls; counts the request."""
    caller = state.keys.caller(authorization, x_api_key)
    await state.desk.admit(caller)
    return caller


CallerDep = Annotated[Caller, Depends(caller_of)]
