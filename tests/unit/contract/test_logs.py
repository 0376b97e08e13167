"""Structured logs."""

import json
import logging

from partuv_contract.logs import JsonFormatter, log_context


def test_whatever_is_said_stays_on_one_line() -> None:
    record = logging.makeLogRecord(
        {"msg": "an\u2028event", "levelname": "INFO", "path": "\x85\u2029\r\n"}
    )
    with log_context(job_id="job_1", request_id="from\nafar"):
        (text,) = JsonFormatter().format(record).splitlines()
    line = json.loads(text)
    assert (line["event"], line["path"]) == ("an\u2028event", "\x85\u2029\r\n")
    assert (line["job_id"], line["request_id"], line["level"]) == ("job_1", "from\nafar", "info")
