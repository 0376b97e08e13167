"""The Celery application. Importing it loads neither torch nor the engine: only children do."""

from __future__ import annotations

from typing import Any

from celery import Celery, bootsteps
from partuv_store.broker import TASK, celery_settings

from partuv_worker.run.runtime import Runtime
from partuv_worker.settings import WorkerSettings

_TOUCH_S = 5.0


def create_app(settings: WorkerSettings) -> Celery:
    """An application whose worker runs jobs; opens nothing until the worker starts."""
    app = Celery("partuv", set_as_current=False)
    url = settings.redis_url.get_secret_value()
    app.conf.update(celery_settings(url, settings.key_prefix, settings.visibility_timeout_s))
    app.conf.update(
        # The slots are threads that supervise; the work is done in processes of their own.
        worker_pool="threads",
        worker_concurrency=settings.slots,
        worker_prefetch_multiplier=1,
        task_acks_late=True,
        task_reject_on_worker_lost=True,
        # A running job outlives a lost connection: its lease in the store decides, not the message.
        worker_cancel_long_running_tasks_on_connection_loss=False,
        worker_enable_remote_control=False,
        worker_send_task_events=False,
    )
    runtime = Runtime(settings)

    @app.task(name=TASK, bind=True)  # type: ignore[untyped-decorator]
    def unwrap(task: Any, job_id: str) -> None:
        runtime.handle(job_id, str((task.request.headers or {}).get("request_id", "")))

    app.steps["worker"].add(_life_of(runtime))
    if settings.health_file is not None:
        app.steps["worker"].add(_pulse_to(settings.health_file.touch))
    return app


def _life_of(runtime: Runtime) -> type[bootsteps.StartStopStep]:
    class Life(bootsteps.StartStopStep):  # type: ignore[misc]
        """Starts and stops what the jobs need with the worker."""

        requires = ("celery.worker.components:Pool",)

        def start(self, worker: Any) -> None:
            runtime.start()

        def stop(self, worker: Any) -> None:
            runtime.stop()

        terminate = stop

    return Life


def _pulse_to(touch: Any) -> type[bootsteps.StartStopStep]:
    class Pulse(bootsteps.StartStopStep):  # type: ignore[misc]
        """Touches a file from the loop that fetches messages: it goes stale when that stops."""

        requires = ("celery.worker.components:Timer",)

        def start(self, worker: Any) -> None:
            worker.timer.call_repeatedly(_TOUCH_S, touch)

    return Pulse
