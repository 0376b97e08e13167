import pytest
from partuv_worker.cli.files import plan_jobs, write_atomically


def test_a_file_goes_where_it_is_told(tmp_path):
    (job,) = plan_jobs(tmp_path / "a.glb", tmp_path / "b.glb", None, tmp_path / "b.png")
    assert (job.source.name, job.target.name, job.preview.name) == ("a.glb", "b.glb", "b.png")
    (job,) = plan_jobs(tmp_path / "a.glb", tmp_path, None, None)
    assert job.target == tmp_path / "a.glb"


def test_a_folder_is_laid_out_alike_and_results_are_not_read_again(tmp_path):
    for name in ("x.glb", "deep/y.GLB", "notes.txt", "out/x.glb"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    jobs = plan_jobs(tmp_path, tmp_path / "out", tmp_path / "reports", None)
    assert [str(job.target.relative_to(tmp_path)) for job in jobs] == [
        "out/deep/y.GLB",
        "out/x.glb",
    ]
    assert str(jobs[0].report.relative_to(tmp_path)) == "reports/deep/y.json"


def test_a_failed_write_leaves_the_old_file_and_no_other(tmp_path):
    path = tmp_path / "new" / "a.glb"
    write_atomically(path, b"old")
    with pytest.raises(TypeError):
        write_atomically(path, "not bytes")
    assert path.read_bytes() == b"old"
    assert [found.name for found in path.parent.iterdir()] == ["a.glb"]
