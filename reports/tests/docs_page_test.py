# SPDX-License-Identifier: Zlib
"""Charts on pages of docs/: picture, finding and numbers are of the same data, written by one command, compared here."""

import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import docs_page  # noqa: E402
import make  # noqa: E402
import synthetic_store  # noqa: E402

ROOT = HERE.parent.parent
CHART = "resolvers_pyramid__2d"
MARKS = f"# Title\n\n<!-- chart {CHART} -->\n<!-- end -->\n\nthe rest\n"


class DocsPage(unittest.TestCase):
    def test_pictures_findings_and_numbers_agree(self):
        pages = [page for page in sorted((ROOT / "docs").glob("*.md"))
                 if docs_page.MARKS.search(page.read_text(encoding="utf-8"))]
        self.assertIn("evidence.md", [page.name for page in pages])
        for page in pages:
            self.assertEqual(docs_page.faults(page), [], page.name)
        used = {found[1] for page in pages for found in docs_page.MARKS.finditer(page.read_text(encoding="utf-8"))}
        figures = ROOT / "docs" / "figures"
        self.assertEqual({path.name for path in figures.iterdir()}, {f"{name}.png" for name in used} | {docs_page.NUMBERS})
        self.assertEqual(docs_page.read_numbers(figures).keys(), used)

    def test_a_page_of_other_data_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            store, page = Path(folder) / "s.db", Path(folder) / "page.md"
            synthetic_store.write(store, themes=(synthetic_store.one_scene,))
            page.write_text(MARKS, encoding="utf-8")
            self.assertEqual(docs_page.faults(page), [f"{CHART}: {CHART}.png, or {CHART}.json in numbers.zip, is missing"])
            self.assertEqual(make.main(["--store", str(store), "--page", str(page)]), 0)
            written = page.read_text(encoding="utf-8")
            self.assertTrue(written.startswith("# Title") and written.endswith("the rest\n"))
            self.assertIn("`build/release/bin/lpc sweep resolvers --store results/s.db`", written)
            self.assertEqual(docs_page.faults(page), [])
            figures = page.parent / "figures"
            packed = (figures / "numbers.zip").read_bytes()
            docs_page.write_numbers({**docs_page.read_numbers(figures), "of_no_page": "{}"}, figures)
            self.assertNotEqual((figures / "numbers.zip").read_bytes(), packed)
            self.assertEqual(make.main(["--store", str(store), "--page", str(page)]), 0)  # it finds its marks again
            self.assertEqual(page.read_text(encoding="utf-8"), written)
            self.assertEqual((figures / "numbers.zip").read_bytes(), packed, "the same numbers, other bytes")
            page.write_text(written.replace("naive", "catto"), encoding="utf-8")
            self.assertEqual(docs_page.faults(page), [f"{CHART}: the text of the page differs from {CHART}.json"])
            docs_page.write_numbers({name: text.replace("naive", "catto")
                                     for name, text in docs_page.read_numbers(figures).items()}, figures)
            self.assertEqual(docs_page.faults(page), [f"{CHART}: the data of the picture differ from {CHART}.json"])

    def test_mistakes_are_told_in_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            store, page = Path(folder) / "s.db", Path(folder) / "page.md"
            synthetic_store.write(store, themes=())
            for text in ("no marks\n", MARKS):
                page.write_text(text, encoding="utf-8")
                self.assertEqual(make.main(["--store", str(store), "--page", str(page)]), 2)
            self.assertEqual(sorted(p.name for p in Path(folder).iterdir()), ["page.md", "s.db"])


if __name__ == "__main__":
    unittest.main()
