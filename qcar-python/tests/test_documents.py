"""What the documents and the notebook show runs."""

import re

import pytest


@pytest.mark.parametrize("page", ["docs/python.md", "qcar-python/README.md"])
def test_python_of_a_page_runs(page, repository, monkeypatch):
    blocks = re.findall(r"```python\n(.*?)```", (repository / page).read_text(), flags=re.DOTALL)
    assert blocks
    monkeypatch.chdir(repository)
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)


def test_the_notebook_runs_and_holds_no_results(repository):
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed: the notebook is passed over")
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed: the notebook is passed over")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed: the notebook is passed over")
    for file in sorted((repository / "qcar-python" / "examples").glob("*.ipynb")):
        notebook = nbformat.read(file, as_version=4)
        nbformat.validate(notebook)
        code = [cell for cell in notebook.cells if cell.cell_type == "code"]
        assert code and not any(cell.outputs or cell.execution_count for cell in code), f"{file.name} holds results"
        folder = {"metadata": {"path": str(file.parent)}}
        nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources=folder).execute()
        shown = [output for cell in code for output in cell.outputs]
        assert any("text/html" in output.get("data", {}) for output in shown), "no table is shown"
