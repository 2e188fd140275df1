# Reads a series that no trial stores.
edit(reports/metrics.py "np.max(trial.series(\"height\"))" "np.max(trial.series(\"hieght\"))")
