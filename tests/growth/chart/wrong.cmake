# It needs a series that nobody stores, and would be a chart that is never made.
edit(reports/charts/tallest.py "series=(\"height\",)" "series=(\"hieght\",)")
