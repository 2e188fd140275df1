# It reads a series that nobody stores.
edit(reports/metrics.py "np.max(trial.series(\"height\"))" "np.max(trial.series(\"hieght\"))")
