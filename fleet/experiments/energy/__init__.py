"""The energy study: is the paper's Eq. (1), energy linear in straight distance, true of motion?"""
