"""Tables as objects of pandas, which is not needed otherwise."""

from collections.abc import Mapping
from typing import Any


def dataframe(columns: Mapping[str, Any]) -> Any:
    """Return a DataFrame of columns of one length, by their headings. Raises ImportError without pandas."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError("pandas is needed for data frames: pip install 'isopeel[study]'") from error
    return pandas.DataFrame(dict(columns))
