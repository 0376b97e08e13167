"""What can go wrong with a part prior: two leaves of the tree in `partuv_contract.errors`."""

from partuv_contract.errors import PartuvError


class FeaturesError(PartuvError):
    """The part prior that was asked for can't run here."""

    code = "features_unavailable"
    http_status = 503
    grpc_status = "UNAVAILABLE"


class CheckpointError(FeaturesError):
    """A checkpoint that is missing, damaged, hostile or of another network."""

    code = "bad_checkpoint"
