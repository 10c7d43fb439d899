"""Studies: runs of a case with other values of some of its keys, their table, figures and report.

Start at `study.study` and `study.study_file` (what a study is), `study.design` (which runs it has),
`study.execution` (how they are computed), `study.run` and `study.report`.
"""
