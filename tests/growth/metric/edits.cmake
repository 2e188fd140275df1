edit(reports/metrics.py "def known(store):" [[
@metric("highest body", "m", "highest that the centre of a body ever was", "", ("height",))
def highest(trial):
    return float(np.max(trial.series("height")))


def known(store):]])
