"""Problems under risk."""
